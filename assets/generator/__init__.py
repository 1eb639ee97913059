"""The programs that make the built-in head from hand-placed numbers.

Reading order: `form` says what the head looks like (an implicit surface put together from
`sections`, `nose` and `lips`); `eye_rows`, `mouth_rows`, `nostril_rows`, `ear_rows` and
`outline` say where vertices must lie; `infill` and `remesh` fill the rest with triangles; `skin`
puts one half together and mirrors it; `landmarks`, `bones`, `eyeballs`, `lashes`, `dentition` and
`oral` add what belongs to it, `ambient` the darkness within the mouth. `unwrap` lays the skin flat;
`painting` paints it there, with `texels`, `regions`, `pigments`, `brows` and `noise`. `finer` lays
more triangles on the same form. `assets.build` runs all of them.

No mesh, scan or template of anybody is behind it. Millimetres, x toward the subject's
left, y up, z toward the viewer; the pupils lie near y = 0 and x = 0 is the mirror plane.
"""
