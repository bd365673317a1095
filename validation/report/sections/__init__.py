"""One module for each kind of evidence: it turns results into parts of a document and decides nothing."""
