"""Opening and saving of scripts, heads and exports, with the dialogs for their files."""
