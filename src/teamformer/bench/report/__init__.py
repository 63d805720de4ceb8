"""What rows come to: tables, figures, claims of the paper and the document of results."""
