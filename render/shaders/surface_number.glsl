// The number and the depth (16 bits) of the surface that a pixel shows. A colour texture holds both,
// because software OpenGL reads it much faster than a depth texture.

uniform vec3 numbers;      // number of the front, its growth up to normals that point up, number of the back
uniform vec2 depth_range;  // smallest depth of the scene, and reciprocal of the range of its depths

// rise: y of the normal. It separates touching lips, which have the same depth.
float surface_number(float rise) {
#if defined(TRIANGLES)
    // Each triangle has its own colour. Of 188 neighbours, one has the same number.
    float number = 1.0 + mod(numbers.x + 37.0 * float(gl_PrimitiveID % 188), 188.0);
#else
    float number = numbers.x + numbers.y * clamp(0.5 + 0.5 * rise, 0.0, 1.0);
#endif
    return (gl_FrontFacing ? number : numbers.z) / 255.0;
}

// The alpha is 1, so that blending does not mix numbers.
vec4 surface_and_depth(float rise) {
    float steps = 255.0 * clamp((gl_FragCoord.z - depth_range.x) * depth_range.y, 0.0, 1.0);
    return vec4(surface_number(rise), floor(steps) / 255.0, fract(steps), 1.0);
}
