"""The paper: Kähler, Haber, Seidel 2003, section 4.

refiner.py      a frame, from top to bottom; frame.py has the arrays that its passes share
criterion.py    4.1  how often each edge is split
smoothing.py    4.2  where vertices and new points go
table.py        4.3  the 27 patterns; look_up.py numbers points and looks triangles up
coherence.py    4.4  triangulations that continue those of the frame before
"""
