"""The window: all parts joined, its loop, its menus, and what is seen before it is ready."""
