"""Files that are read and written: scripts, heads, exports, and the dialogs for them."""
