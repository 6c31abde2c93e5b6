// GLSL: shaded two-sided surfaces, the ground with its grid and soft shadow, and the shadow's map seen from above.

export const SURFACE = {
  vertex: `#version 300 es
    in vec3 position; in vec3 normal; in vec4 colour;
    uniform mat4 matrix;
    uniform float lift;
    out vec3 vNormal; out vec3 vPlace; out vec4 vColour;
    void main() {
      vec3 place = position + lift * normal;
      vNormal = normal; vPlace = place; vColour = colour;
      gl_Position = matrix * vec4(place, 1.0);
    }`,
  fragment: `#version 300 es
    precision highp float;
    in vec3 vNormal; in vec3 vPlace; in vec4 vColour;
    uniform vec3 eye; uniform vec3 towards; uniform float perspective;
    uniform vec3 front; uniform vec3 back; uniform float coloured; uniform float alpha; uniform float shine;
    out vec4 result;
    void main() {
      vec3 view = normalize(mix(towards, eye - vPlace, perspective));
      vec3 n = normalize(vNormal);
      bool isFront = dot(n, view) >= 0.0;
      if (!isFront) n = -n;
      vec3 base = mix(isFront ? front : back, vColour.rgb, coloured * vColour.a);
      vec3 key = normalize(vec3(-0.45, -0.55, 0.8));
      vec3 fill = normalize(vec3(0.7, 0.3, 0.35));
      float sky = 0.5 + 0.5 * n.z;
      float light = 0.36 + 0.16 * sky + 0.46 * max(dot(n, key), 0.0) + 0.14 * max(dot(n, fill), 0.0);
      float rim = pow(1.0 - max(dot(n, view), 0.0), 3.0);
      float gloss = shine * pow(max(dot(n, normalize(key + view)), 0.0), 28.0);
      vec3 lit = base * (light - 0.10 * rim) + gloss;
      result = vec4(pow(lit, vec3(0.96)), alpha);
    }`,
};

export const GROUND = {
  vertex: `#version 300 es
    in vec2 corner;
    uniform mat4 matrix; uniform vec2 centre; uniform float reach; uniform float level;
    out vec2 vPlace; out vec2 vShare;
    void main() {
      vPlace = centre + reach * corner; vShare = corner;
      gl_Position = matrix * vec4(vPlace, level, 1.0);
    }`,
  fragment: `#version 300 es
    precision highp float;
    in vec2 vPlace; in vec2 vShare;
    uniform sampler2D shadow; uniform vec3 line; uniform float lineAlpha; uniform float shade; uniform float stepMm;
    out vec4 result;
    float grid(float size) {
      vec2 at = vPlace / size;
      vec2 away = abs(fract(at - 0.5) - 0.5) / fwidth(at);
      return 1.0 - min(min(away.x, away.y), 1.0);
    }
    void main() {
      float dark = shade * texture(shadow, 0.5 + 0.5 * vShare).r;
      float fade = smoothstep(1.0, 0.25, length(vShare));
      float lines = lineAlpha * fade * max(0.5 * grid(stepMm), grid(5.0 * stepMm));
      float alpha = dark + lines * (1.0 - dark);
      result = vec4(line * lines * (1.0 - dark) / max(alpha, 1e-4), alpha);
    }`,
};

/** One of two passes that blur the shadow, along x or along y. The ground then reads one value a pixel. */
export const BLUR = {
  vertex: `#version 300 es
    in vec2 corner;
    out vec2 vAt;
    void main() { vAt = 0.5 + 0.5 * corner; gl_Position = vec4(corner, 0.0, 1.0); }`,
  fragment: `#version 300 es
    precision highp float;
    in vec2 vAt;
    uniform sampler2D map; uniform vec2 way;
    out vec4 result;
    void main() {
      float dark = 0.0, total = 0.0;
      for (int i = -4; i <= 4; i++) {
        float weight = exp(-float(i * i) / 9.0);
        dark += weight * texture(map, vAt + float(i) * way).r;
        total += weight;
      }
      result = vec4(dark / total);
    }`,
};

export const SHADOW = {
  vertex: `#version 300 es
    in vec3 position;
    uniform vec2 centre; uniform float reach;
    void main() { gl_Position = vec4((position.xy - centre) / reach, 0.0, 1.0); }`,
  fragment: `#version 300 es
    precision highp float;
    out vec4 result;
    void main() { result = vec4(1.0); }`,
};
