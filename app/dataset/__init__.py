"""Make labelled pictures of faces; a seed and a number determine each picture."""
