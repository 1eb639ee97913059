// The farthest depth of each square tile of the layer, of all its samples; SAMPLES and TILE say
// how many samples a pixel has, and how many pixels a tile has each way.

#if defined(VERTEX_STAGE)

void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}

#elif defined(FRAGMENT_STAGE)

uniform sampler2DMS depths;
out float farthest;

void main() {
    ivec2 first = ivec2(gl_FragCoord.xy) * TILE;
    ivec2 last = textureSize(depths) - 1;
    farthest = 0.0;
    for (int y = 0; y < TILE; y++)
        for (int x = 0; x < TILE; x++)
            for (int i = 0; i < SAMPLES; i++)
                farthest = max(farthest, texelFetch(depths, min(first + ivec2(x, y), last), i).r);
}

#endif
