// The mean of all samples of the layer's pixel; SAMPLES is how many there are.

#if defined(VERTEX_STAGE)

void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}

#elif defined(FRAGMENT_STAGE)

uniform sampler2DMS layer;
out vec4 pixel_colour;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < SAMPLES; i++) sum += texelFetch(layer, pixel, i);
    pixel_colour = sum / float(SAMPLES);
}

#endif
