"""Live faces: sockets, packets, and a face that fades in and out."""
