"""What VASO shows: views for the terminal (rich) and self-contained HTML pages."""
