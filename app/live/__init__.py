"""Live faces: sockets, formats of packets, and the fading in and out of a received face."""
