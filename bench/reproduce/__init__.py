"""The paper, made anew: what it says and shows, each beside what was measured here."""
