"""What evidence hands in to a report, and the forms that a report has."""
