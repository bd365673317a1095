"""What is measured on a run, and how far two runs are apart."""
