"""The means by which all panels are drawn: Dear ImGui in the window, commands, small widgets."""
