"""Recordings that other programs made of a face: files and packets of their kinds, as one `Take`.

`reading.read_take` reads a file. A `calibration.Calibration` takes the face at rest away, and
`mapping.controls_of` gives the controls of a face that its channels move.
"""
