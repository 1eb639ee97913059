"""Tools for all panels: Dear ImGui in the window, commands, small widgets."""
