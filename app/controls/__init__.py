"""Names of controls: what they are called in plain words, and what a mirror makes of them."""
