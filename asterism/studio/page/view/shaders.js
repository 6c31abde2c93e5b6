// GLSL: surfaces in the light of one sun and of the sky, lines, and how much of the sky the points of a surface see.

/** Maps of depths: the first is seen from the sun, the others from directions over the whole sky. */
export const LIGHTS = 17;

const MAPS = `
  uniform highp sampler2DArrayShadow maps;
  uniform mat4 seen[${LIGHTS}]; uniform vec3 ways[${LIGHTS}];
  uniform float away; uniform float texel;
  float open(int light, vec3 place, vec2 step) {
    vec3 at = 0.5 + 0.5 * (seen[light] * vec4(place, 1.0)).xyz;
    return texture(maps, vec4(at.xy + texel * step, float(light), at.z));
  }`;

/** Share of the sky over both sides of each point, for a transform feedback. */
export const SKY = {
  feedback: "sky",
  vertex: `#version 300 es
    precision highp float;
    in vec3 position; in vec3 normal;
    out vec2 sky;
    ${MAPS}
    float share(vec3 n) {
      float all = 0.0, free = 0.0;
      for (int k = 1; k < ${LIGHTS}; k++) {
        float part = max(dot(n, ways[k]), 0.0);
        all += part;
        if (part > 0.0) free += part * open(k, position + 2.0 * away * n, vec2(0.0));
      }
      return (0.5 + 0.5 * n.z) * (all > 0.0 ? free / all : 1.0);
    }
    void main() {
      vec3 n = normalize(normal);
      sky = vec2(share(n), share(-n));
    }`,
  fragment: `#version 300 es
    void main() {}`,
};

const VERTEX = `#version 300 es
  in vec3 position; in vec3 normal; in vec4 colour; in vec2 printed; in vec2 sky;
  uniform mat4 matrix;
  uniform float lift;
  out vec3 vNormal; out vec3 vPlace; out vec4 vColour; out vec2 vPrinted; out vec2 vSky;
  void main() {
    vNormal = normal; vColour = colour; vPrinted = printed; vSky = sky; vPlace = position + lift * normal;
    gl_Position = matrix * vec4(vPlace, 1.0);
  }`;

export const SURFACE = {
  vertex: VERTEX,
  fragment: `#version 300 es
    precision highp float;
    in vec3 vNormal; in vec3 vPlace; in vec4 vColour; in vec2 vPrinted; in vec2 vSky;
    uniform vec3 eye; uniform vec3 towards; uniform float perspective; uniform float hasSky; uniform float soft;
    uniform vec3 base; uniform vec3 back; uniform float coloured; uniform float alpha; uniform float shine; uniform float weave;
    out vec4 result;
    ${MAPS}
    void main() {
      vec3 view = normalize(mix(towards, eye - vPlace, perspective));
      vec3 n = normalize(vNormal);
      bool isFront = dot(n, view) >= 0.0;
      if (!isFront) n = -n;
      float sun = max(dot(n, ways[0]), 0.0);
      if (sun > 0.0) {
        vec3 place = vPlace + away * n;
        int taps = soft > 0.0 ? 4 : 1;
        float clear = 0.0;
        for (int k = 0; k < taps; k++) clear += open(0, place, soft * vec2(k < 2 ? -0.8 : 0.8, k % 2 == 0 ? -0.8 : 0.8));
        sun *= clear / float(taps);
      }
      float sky = mix(0.5 + 0.5 * n.z, isFront ? vSky.x : vSky.y, hasSky);
      vec3 paint = mix(isFront ? base : back, vColour.rgb, coloured * vColour.a);
      if (weave > 0.0) {
        vec2 thread = 3.1416 * vPrinted / 0.6;
        float fine = 1.0 - smoothstep(0.6, 2.0, length(fwidth(thread)));
        paint *= 1.0 + weave * fine * sin(thread.x) * sin(thread.y);
      }
      // the light adds up in linear intensities, of which colours are about the square roots
      vec3 light = vec3(0.07, 0.068, 0.066) + vec3(0.40, 0.42, 0.45) * sky + vec3(0.60, 0.57, 0.52) * sun;
      light += vec3(0.20, 0.19, 0.18) * (0.5 - 0.5 * n.z); // from the board below
      float gloss = shine * pow(max(dot(n, normalize(ways[0] + view)), 0.0), 28.0) * step(1e-3, sun);
      result = vec4(sqrt(paint * paint * light + gloss), alpha);
    }`,
};

export const LINE = {
  vertex: VERTEX,
  fragment: `#version 300 es
    precision highp float;
    uniform vec3 base; uniform float alpha;
    out vec4 result;
    void main() { result = vec4(base, alpha); }`,
};
