"""What all panels are drawn with: Dear ImGui in the window, commands, small widgets."""
