"""Many commands, done one beside the other.

listing.py   the lines of a list, and what is wrong with them
journal.py   what was made by which line, of what: `--resume` asks it
running.py   the lines that are to be done, and what became of them
summary.py   that as a table, and as a file
"""
