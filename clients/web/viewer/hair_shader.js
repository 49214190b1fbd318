// The shader of the hair: A(x) (Kd D(t) + Ks S(t, theta')) at every fragment of a strand.
import { atlas_columns, atlas_rows } from './cube_atlas.js';
import { angle_polynomial, glsl_number, glsl_polynomial, sine_polynomial } from './shader_math.js';

export const most_lights = 8;

/** The transmittance of an added light: the number that the shader takes for it. */
export const hidden_by = { average: 0, harmonics: 1, cone: 2 };

// The attributes of the directional transmittance's harmonics, a vec4 each.
const sh_names = [0, 1, 2, 3].map(i => `sh${i}`);
const each_sh = line => sh_names.map((name, i) => `#if SH_VECTORS > ${i}\n${line(name, i)}\n#endif`).join('\n');

export const vertex_shader = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
in vec3 position;
in vec4 tangent_and_transmittance;
out vec3 v_position;
out vec4 v_tangent_and_transmittance;
${each_sh(name => `in vec4 ${name}; out vec4 v_${name};`)}
#ifdef CONE
in vec4 bent_cone;
out vec3 v_moment;

// (1 + cos(angle)) / 2 = sin((pi - angle) / 2)^2, angle in [0, pi].
float cone_moment(float angle) {
    float u = clamp(${Math.PI / 2} - 0.5 * angle, 0.0, ${Math.PI / 2}), u2 = u * u;
    float sine = u * ${glsl_polynomial(sine_polynomial, 'u2')};
    return sine * sine;
}
#endif

void main() {
    v_position = position;
    v_tangent_and_transmittance = tangent_and_transmittance;
${each_sh(name => `    v_${name} = ${name};`)}
#ifdef CONE
    // A |b| axis is a mean over directions, so it may be interpolated along the strand. Axis and angle may not.
    v_moment = bent_cone.xyz * (tangent_and_transmittance.w * cone_moment(bent_cone.w));
#endif
    gl_Position = projectionMatrix * (viewMatrix * vec4(position, 1.0));
}
`;

const look_up = `
// The texture coordinates of a direction in the atlas of cube_atlas.js.
vec2 atlas_place(vec3 d) {
    vec3 m = abs(d);
    vec2 ab;
    int face;
    if (m.x >= m.y && m.x >= m.z) {
        face = d.x > 0.0 ? 0 : 1;
        ab = vec2(d.x > 0.0 ? -d.z : d.z, -d.y) / m.x;
    } else if (m.y >= m.z) {
        face = d.y > 0.0 ? 2 : 3;
        ab = vec2(d.x, d.y > 0.0 ? d.z : -d.z) / m.y;
    } else {
        face = d.z > 0.0 ? 4 : 5;
        ab = vec2(d.z > 0.0 ? d.x : -d.x, -d.y) / m.z;
    }
    vec2 cell = vec2(face % ${atlas_columns}, face / ${atlas_columns});
    vec2 texel = cell * (u_face_size + 2.0) + 1.0 + (0.5 * ab + 0.5) * u_face_size;
    return texel / (vec2(${glsl_number(atlas_columns)}, ${glsl_number(atlas_rows)}) * (u_face_size + 2.0));
}

vec3 map_at(vec2 place, float layer) { return textureLod(u_maps, vec3(place, layer), 0.0).rgb; }

float angle_between(vec3 a, vec3 b) {
    bool wide = dot(a, b) < 0.0;
    vec3 d = wide ? a + b : a - b;
    float q = dot(d, d);
    float angle = sqrt(q) * ${glsl_polynomial(angle_polynomial, 'q')};
    return wide ? ${Math.PI} - angle : angle;
}

// Layer 0 is the diffuse map, 1 + m the specular map of theta'_m = m pi / M.
vec3 light_of_maps(vec3 tangent, vec3 to_eye) {
    vec2 place = atlas_place(u_to_maps * tangent);
    float x = u_intervals * angle_between(tangent, to_eye) * ${1 / Math.PI};
    float m = clamp(floor(x), 0.0, u_intervals - 1.0);
    vec3 specular = mix(map_at(place, 1.0 + m), map_at(place, 2.0 + m), x - m);
    return u_map_gain * (u_kd * map_at(place, 0.0) + u_ks * specular);
}
`;

const added_lights = `
#ifdef CONE
// T of a bent cone in the light's direction: BentCone in core/render/vertex_transmittance.cpp.
float seen_in_cone(float average, vec3 moment, vec3 light) {
    if (!(average > 0.0)) return 0.0;
    float first = length(moment), b = min(1.0, first / average);
    float cosine = 2.0 * b - 1.0, border = min(0.25, 1.0 - abs(cosine)), share = 1.0 - b;
    float inside = share > average ? average / share : 1.0;
    float beyond = (first > 0.0 ? dot(moment, light) / first : 0.0) - cosine;
    if (beyond >= border) return inside;
    return beyond <= -border ? 0.0 : inside * 0.5 * (1.0 + beyond / border);
}
#endif

float seen_from_light(int i, float average) {
#if SH_VECTORS > 0
    if (u_hidden_by == ${hidden_by.harmonics}) {
        float t = 0.0;
${each_sh((name, k) => `        t += dot(v_${name}, u_light_harmonics[4 * i + ${k}]);`)}
        return clamp(t, 0.0, 1.0);
    }
#endif
#ifdef CONE
    if (u_hidden_by == ${hidden_by.cone}) return seen_in_cone(average, v_moment, u_light_direction[i]);
#endif
    return average;
}

// max(0, cosine)^p; p = 0 is the indicator of a positive cosine.
float lobe(float cosine) { return cosine > 0.0 ? (u_exponent > 0.0 ? pow(min(cosine, 1.0), u_exponent) : 1.0) : 0.0; }

// The exact kernels of Kajiya and Kay.
vec3 light_of_added(vec3 tangent, vec3 to_eye, float average) {
    float eye_sine = length(cross(tangent, to_eye)), eye_cosine = dot(tangent, to_eye);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < ${most_lights}; i++) {
        if (i >= u_lights) break;
        float sine = length(cross(tangent, u_light_direction[i])), cosine = dot(tangent, u_light_direction[i]);
        float seen = u_apply_transmittance ? seen_from_light(i, average) : 1.0;
        vec3 sent = u_kd * sine + u_ks * lobe(sine * eye_sine - cosine * eye_cosine);
        sum += seen * u_light_irradiance[i] * sent;
    }
    return sum;
}
`;

const display = `
// Narkowicz's fit of the ACES film curve, then sRGB, as in core/output/tone.cpp.
vec3 shown(vec3 radiance) {
    vec3 x = max(radiance * u_display_gain, 0.0);
    vec3 film = clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
    return mix(12.92 * film, 1.055 * pow(film, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, film));
}
`;

export const fragment_shader = `
precision highp float;
precision highp sampler2DArray;
uniform vec3 cameraPosition;
uniform sampler2DArray u_maps;
uniform float u_face_size, u_intervals, u_exponent;
uniform mat3 u_to_maps;          // the sky's rotation undone: a sky turned by R is looked up at R^-1 t
uniform vec3 u_map_gain;         // exposure, tint and the scale of the halves
uniform vec3 u_kd, u_ks;
uniform bool u_apply_transmittance, u_show_transmittance;
uniform int u_lights, u_hidden_by;
uniform vec3 u_light_direction[${most_lights}], u_light_irradiance[${most_lights}];
uniform vec4 u_light_harmonics[${4 * most_lights}];
uniform bool u_linear;           // no tone curve, for reading back
uniform float u_display_gain;
in vec3 v_position;
in vec4 v_tangent_and_transmittance;
${each_sh(name => `in vec4 v_${name};`)}
#ifdef CONE
in vec3 v_moment;
#endif
layout(location = 0) out vec4 pixel;
${look_up}${added_lights}${display}
void main() {
    float average = v_tangent_and_transmittance.w;
    if (u_show_transmittance) {
        pixel = vec4(vec3(average), 1.0);
        return;
    }
    float size = length(v_tangent_and_transmittance.xyz);
    vec3 tangent = size > 1e-6 ? v_tangent_and_transmittance.xyz / size : vec3(0.0, 1.0, 0.0);
    vec3 to_eye = normalize(cameraPosition - v_position);
    vec3 radiance = (u_apply_transmittance ? average : 1.0) * light_of_maps(tangent, to_eye) +
                    light_of_added(tangent, to_eye, average);
    pixel = vec4(u_linear ? radiance : shown(radiance), 1.0);
}
`;
