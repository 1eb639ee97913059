"""The window: all parts joined, its loop, its menus, and its splash screen."""
