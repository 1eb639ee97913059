"""What refinement costs and what it gains, beside what others offer for the same work."""
