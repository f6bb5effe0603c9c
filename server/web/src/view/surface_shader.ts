// How a surface is drawn. Triangles have no attributes but their corners: what belongs to one, its numbers and which of
// its edges are lines, is read from a texture by its number, so that a million of them take one call, other colours
// cost nothing, and lines need no geometry of their own.

export const kTextureWidth = 2048;

const kCommonVertex = /* glsl */ `
  uniform vec4 section;
  flat out int triangle;
  out float cut;

  void place() {
    triangle = gl_VertexID / 3;
    cut = dot(section.xyz, position) - section.w;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }
`;

export const kSurfaceVertex = /* glsl */ `
  ${kCommonVertex}
  out vec3 corner;
  out vec3 seen;

  void main() {
    place();
    int c = gl_VertexID % 3;
    corner = vec3(c == 0, c == 1, c == 2);
    seen = (modelViewMatrix * vec4(position, 1.0)).xyz;
  }
`;

/** What is known of a triangle and of its patch. */
const kTold = /* glsl */ `
  uniform sampler2D faces;
  uniform sampler2D patches;  // of each patch: the colour of its surface, and 1 if that surface is chosen
  uniform int patchCount;
  uniform vec3 plain;
  flat in int triangle;

  vec4 numbersOf(int id) {
    return texelFetch(faces, ivec2(id % ${kTextureWidth}, id / ${kTextureWidth}), 0);
  }
  vec4 surfaceOf(int id) {
    if (id < 0 || id >= patchCount) return vec4(plain, 0.0);
    return texelFetch(patches, ivec2(id % ${kTextureWidth}, id / ${kTextureWidth}), 0);
  }
`;

export const kSurfaceFragment = /* glsl */ `
  ${kTold}
  uniform bool hasChosen;     // some surface is chosen
  uniform int colouring;      // 0 plain, 1 patch, 2 smallest angle, 3 radius-edge ratio, 4 surface, 5 scale, 6 label
  uniform sampler2D numbers;  // of each triangle: its place on the scale, or its label
  uniform bool isOverlay;     // nothing but lines, over another surface
  uniform float lineWidth;    // pixels; 0: none
  uniform vec3 inside;
  uniform vec3 lineColour;
  uniform vec3 featureColour;
  uniform vec3 openColour;
  uniform vec3 selectedColour;
  uniform vec3 keptColour;
  uniform vec3 scale[5];      // colours from bad to good
  uniform int selected;
  uniform bool showsKept;
  in float cut;
  in vec3 corner;
  in vec3 seen;
  out vec4 colour;

  vec3 ramp(float x) {
    float at = clamp(x, 0.0, 1.0) * 4.0;
    int below = min(int(at), 3);
    return mix(scale[below], scale[below + 1], at - float(below));
  }

  vec3 patchColour(float id) {
    if (id < 0.0) return plain;
    // Steps of the golden ratio: neighbours in number are far apart in hue.
    float hue = fract(id * 0.61803398875 + 0.08);
    float tone = fract(id * 0.38196601125);
    vec3 rgb = clamp(abs(mod(hue * 6.0 + vec3(0.0, 4.0, 2.0), 6.0) - 3.0) - 1.0, 0.0, 1.0);
    return mix(vec3(0.74 + 0.14 * tone), 0.42 + 0.56 * rgb, 0.5);
  }

  vec3 faceColour(vec4 told, vec4 surface) {
    if (colouring == 4) return surface.rgb;
    if (colouring == 1) return patchColour(told.z);
    if (colouring == 2) return ramp(told.x / 60.0);
    if (colouring == 3) return ramp(1.0 - log2(max(told.y, 0.57735) / 0.57735) / 3.0);
    if (colouring >= 5) {
      float number = texelFetch(numbers, ivec2(triangle % ${kTextureWidth}, triangle / ${kTextureWidth}), 0).x;
      return colouring == 5 ? ramp(number) : patchColour(number);
    }
    return plain;
  }

  void main() {
    if (cut > 0.0) discard;
    // Here rather than for each corner: of a million triangles most are behind others.
    vec4 told = numbersOf(triangle);
    vec4 surface = surfaceOf(int(told.z));
    vec3 base = faceColour(told, surface);
    int flags = int(told.w);
    bool isChosen = hasChosen && surface.a > 0.5;
    if (isChosen) base = mix(base, selectedColour, 0.82);
    if (showsKept && (flags & 512) != 0) {
      float stripe = fract((gl_FragCoord.x + gl_FragCoord.y) / 10.0);
      base = mix(base, keptColour, stripe < 0.5 ? 0.85 : 0.35);
    }
    if (triangle == selected) base = selectedColour;

    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    float key = max(dot(normal, normalize(vec3(0.35, 0.55, 0.75))), 0.0);
    float fill = max(dot(normal, normalize(vec3(-0.7, -0.1, 0.7))), 0.0);
    vec3 lit = base * (0.56 + 0.42 * key + 0.14 * fill);
    // The back of a face is the inside of the part: flat, as a cut is drawn.
    vec3 back = triangle == selected ? selectedColour : isChosen ? mix(inside, selectedColour, 0.5) : inside;
    if (!gl_FrontFacing) lit = back * (0.82 + 0.18 * key);

    vec3 width = fwidth(corner);
    vec3 distance = corner / max(width, 1e-9);
    if (isOverlay) {
      for (int k = 0; k < 3; ++k) if ((flags & (1 << k)) != 0) distance[k] = 1e9;
      float nearest = min(min(distance.x, distance.y), distance.z);
      float wide = max(max(width.x, width.y), width.z);
      // Dense triangles would cover what is below them.
      float strength = (1.0 - smoothstep(lineWidth - 0.5, lineWidth + 0.5, nearest)) * smoothstep(2.0, 12.0, 1.0 / wide);
      if (strength < 0.02) discard;
      colour = vec4(selectedColour, strength);
      return;
    }
    if (lineWidth > 0.0) {
      // Where triangles are smaller than lines are wide, lines would be all that there is.
      float room = 1.0 / max(max(width.x, width.y), width.z);
      vec3 mesh = distance;
      vec3 feature = vec3(1e9);
      vec3 open = vec3(1e9);
      for (int k = 0; k < 3; ++k) {
        if ((flags & (1 << k)) != 0) mesh[k] = 1e9;
        // Where surfaces are looked at, the facets of one surface are not told apart more than its triangles are.
        bool isSmooth = (colouring == 4 || hasChosen) && (flags & (1024 << k)) != 0;
        if ((flags & (8 << k)) != 0 && !isSmooth) feature[k] = distance[k];
        if ((flags & (64 << k)) != 0) open[k] = distance[k];
      }
      float thin = 1.0 - smoothstep(lineWidth - 0.5, lineWidth + 0.5, min(min(mesh.x, mesh.y), mesh.z));
      float strong = 1.0 - smoothstep(lineWidth, lineWidth + 1.0, min(min(feature.x, feature.y), feature.z));
      float border = 1.0 - smoothstep(lineWidth + 0.5, lineWidth + 1.5, min(min(open.x, open.y), open.z));
      lit = mix(lit, lineColour, thin * 0.62 * smoothstep(1.5, 9.0, room));
      lit = mix(lit, featureColour, strong * smoothstep(0.8, 8.0, room));
      lit = mix(lit, openColour, border);
    }
    if (triangle == selected) {
      float rim = min(min(distance.x, distance.y), distance.z);
      lit = mix(lit, lineColour, 1.0 - smoothstep(1.5, 2.5, rim));
    }
    colour = vec4(lit, 1.0);
  }
`;

/** Chosen surfaces once more, as they are seen through what is before them. */
export const kGhostVertex = /* glsl */ `
  ${kCommonVertex}
  void main() { place(); }
`;
export const kGhostFragment = /* glsl */ `
  ${kTold}
  uniform vec3 selectedColour;
  in float cut;
  out vec4 colour;
  void main() {
    if (cut > 0.0 || surfaceOf(int(numbersOf(triangle).z)).a < 0.5) discard;
    colour = vec4(selectedColour, 0.2);
  }
`;

/** For picking: each triangle in the colour of its number, from 1. */
export const kPickVertex = /* glsl */ `
  ${kCommonVertex}
  void main() { place(); }
`;
export const kPickFragment = /* glsl */ `
  flat in int triangle;
  in float cut;
  out vec4 colour;
  void main() {
    if (cut > 0.0) discard;
    int id = triangle + 1;
    colour = vec4(id & 255, (id >> 8) & 255, (id >> 16) & 255, (id >> 24) & 255) / 255.0;
  }
`;
