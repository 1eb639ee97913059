// A soft gradient over the whole viewport, at the far end of depth.

#if defined(VERTEX_STAGE)

out vec2 place;  // -1..1 over the viewport

void main() {
    place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
    gl_Position = vec4(place, 1.0, 1.0);
}

#elif defined(FRAGMENT_STAGE)

in vec2 place;
uniform vec3 centre;
uniform vec3 edge;
out vec4 pixel_colour;

void main() {
    vec2 away = place - vec2(-0.08, 0.16);
    float distance = dot(away, away) * 0.44;
    vec3 colour = mix(centre, edge, distance / (0.35 + distance) * 1.35);
    // Half a grey level of interleaved gradient noise (Jimenez 2014) hides the steps of 8 bits.
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    pixel_colour = vec4(colour + (noise - 0.5) / 255.0, 1.0);
}

#endif
