"""What a user does with a face, what it does in time, and what of it is kept; knows no window."""
