// Which surface a pixel shows: its number, and its depth in 16 bits. Both lie in a target of colours,
// which software reads much faster than one of depths.

uniform vec3 numbers;      // of the front, how much more where it faces up, and of the back
uniform vec2 depth_range;  // of the scene: the least depth, and 1 over how far it reaches

// rise: of the normal. By it lips that lie on each other are two surfaces, at one depth.
float surface_number(float rise) {
#if defined(TRIANGLES)
    // Each has a colour of its own. Neighbours have other numbers, but for one in 188.
    float number = 1.0 + mod(numbers.x + 37.0 * float(gl_PrimitiveID % 188), 188.0);
#else
    float number = numbers.x + numbers.y * clamp(0.5 + 0.5 * rise, 0.0, 1.0);
#endif
    return (gl_FrontFacing ? number : numbers.z) / 255.0;
}

// Opaque, or blending would mix it.
vec4 surface_and_depth(float rise) {
    float steps = 255.0 * clamp((gl_FragCoord.z - depth_range.x) * depth_range.y, 0.0, 1.0);
    return vec4(surface_number(rise), floor(steps) / 255.0, fract(steps), 1.0);
}
