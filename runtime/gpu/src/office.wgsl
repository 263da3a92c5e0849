// The shading of the reference renderer, once more: whatever changes there changes here.
// Before this text stand the constants that both share.

struct Camera {
    // w: pixels a unit of slope.
    eye: vec4<f32>,
    // w of the next two: the optical axis in the picture, pixels.
    right: vec4<f32>,
    down: vec4<f32>,
    // w: how wide a pixel is one metre ahead, squared.
    forward: vec4<f32>,
    // Where its picture begins in the atlas, and how large it is, pixels.
    tile: vec4<f32>,
}

struct Piece {
    // Columns; w: where the mesh's origin lies in the world.
    rotation: array<vec4<f32>, 3>,
    // Columns; w: the light of the room.
    inverse: array<vec4<f32>, 3>,
    tint: vec4<f32>,
    fluid: vec4<f32>,
    id: u32,
    flags: u32,
    room: u32,
    unused: u32,
}

struct Surface {
    // w: 0 for this colour, 1 for the tint, 2 for the fluid.
    paint: vec4<f32>,
    u: vec4<f32>,
    v: vec4<f32>,
    // Shine, squarings, mirror, 1 if coloured.
    gloss: vec4<f32>,
    // Layer or -1, pictures a metre, texels a square metre, what light it has.
    pattern: vec4<f32>,
    // How much it hides squarely and at a glance, its highlight, 1 if it shines by itself.
    veil: vec4<f32>,
}

struct Draw {
    piece: u32,
    camera: u32,
}

struct Shadows {
    origin: vec2<f32>,
    // The greatest place that can be looked up, texels; the least is 2.
    most: vec2<f32>,
    texels_a_metre: f32,
    // The layer of which dirt is made, and pictures a metre of it.
    spots: f32,
    spots_a_metre: f32,
    unused: f32,
}

const DIRTY: u32 = 1u;
const COLD: u32 = 2u;
const INFECTED: u32 = 4u;
const LIT: u32 = 8u;

const GLOW: f32 = 1.0;
const LAMP: f32 = 2.0;
const SKY: f32 = 3.0;

// Whether colour is wanted.
override COLORED: bool = true;
// Whether what is see-through is nothing but colour.
override AIRY: bool = false;

@group(0) @binding(0) var<storage, read> cameras: array<Camera>;
@group(0) @binding(1) var<storage, read> pieces: array<Piece>;
@group(0) @binding(2) var<storage, read> draws: array<Draw>;
@group(0) @binding(3) var<storage, read> surfaces: array<Surface>;
@group(0) @binding(4) var<storage, read> display_bytes: array<u32>;
@group(0) @binding(5) var<uniform> shadows: Shadows;
@group(0) @binding(6) var shadow_map: texture_2d<u32>;
@group(0) @binding(7) var pictures: texture_2d_array<f32>;
@group(0) @binding(8) var smoothly: sampler;

struct Corner {
    @builtin(position) at: vec4<f32>,
    @location(0) normal: vec3<f32>,
    // From the eye, in the world.
    @location(1) away: vec3<f32>,
    // Place on the pattern in pictures, and light from all around.
    @location(2) laid: vec3<f32>,
    @location(3) @interpolate(flat) what: vec3<u32>,
    // Tells triangles apart.
    @location(4) @interpolate(flat, either) facet: u32,
}

struct Pixel {
    @location(0) color: vec4<f32>,
    @location(1) depth_m: f32,
    @location(2) normal: u32,
    @location(3) id: u32,
    @location(4) facet: u32,
}

fn placed(
    position: vec3<f32>,
    normal: vec3<f32>,
    ambient: f32,
    surface: u32,
    vertex: u32,
    instance: u32,
) -> Corner {
    let draw = draws[instance];
    let camera = cameras[draw.camera];
    let r = pieces[draw.piece].rotation;
    let i = pieces[draw.piece].inverse;
    let offset = vec3(r[0].w, r[1].w, r[2].w);
    let away = r[0].xyz * position.x + r[1].xyz * position.y + r[2].xyz * position.z + (offset - camera.eye.xyz);
    let seen = vec3(dot(away, camera.right.xyz), dot(away, camera.down.xyz), dot(away, camera.forward.xyz));
    let size = camera.tile.zw;
    let axis = vec2(camera.right.w, camera.down.w);
    var place = seen.xy * (camera.eye.w / seen.z) + axis;
    if seen.z >= NEAR_M && all(abs(place) < vec2(GUARD_PX)) {
        // To the same fractions of pixels as the reference, so that edges cover the same pixels.
        place = floor(place * SUB + 0.5) / SUB;
    }
    // What is behind the eye has no place in the picture.
    let twice = select(
        2.0 * (seen.xy * camera.eye.w + seen.z * (axis - 0.5 * size)) / size,
        (2.0 * place / size - 1.0) * seen.z,
        seen.z >= NEAR_M,
    );
    var out: Corner;
    // One over depth, reversed: what is near is greater.
    out.at = vec4(twice.x, -twice.y, NEAR_M, seen.z);
    // By the transposed inverse.
    out.normal = vec3(dot(i[0].xyz, normal), dot(i[1].xyz, normal), dot(i[2].xyz, normal));
    out.away = away;
    let u = surfaces[surface].u;
    let v = surfaces[surface].v;
    let per_m = surfaces[surface].pattern.y;
    out.laid = vec3((dot(u.xyz, position) + u.w) * per_m, (dot(v.xyz, position) + v.w) * per_m, ambient);
    out.what = vec3(draw.piece, draw.camera, surface);
    out.facet = instance * 2654435769u + vertex + 1u;
    return out;
}

@vertex
fn corner(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) ambient: f32,
    @location(3) surface: u32,
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> Corner {
    return placed(position, normal, ambient, surface, vertex, instance);
}

// The display byte of a channel, as a share of 255.
fn channel(light: f32) -> f32 {
    let step = u32(clamp(light, 0.0, WHITE) * (4095.0 / WHITE) + 0.5);
    return f32((display_bytes[step >> 2u] >> ((step & 3u) * 8u)) & 255u) / 255.0;
}

fn display(light: vec3<f32>) -> vec3<f32> {
    return vec3(channel(light.r), channel(light.g), channel(light.b));
}

// What is seen where there is no building.
fn outside(ray: vec3<f32>) -> vec3<f32> {
    let horizon = vec3(0.80, 0.87, 0.94);
    let zenith = vec3(0.36, 0.56, 0.86);
    let ground = vec3(0.30, 0.33, 0.26);
    if ray.z >= 0.0 {
        return mix(horizon, zenith, min(ray.z * 2.2, 1.0));
    }
    return mix(horizon, ground, min(-ray.z * 9.0, 1.0));
}

fn factor(layer: f32, at: vec2<f32>, level: f32) -> vec3<f32> {
    return textureSampleLevel(pictures, smoothly, at, i32(layer), level).rgb * (255.0 / 128.0);
}

// How much a tent four texels wide covers of each of four texels.
fn tent(f: f32) -> vec4<f32> {
    return vec4(1.0 - f, 2.0 - f, 1.0 + f, f) * 0.25;
}

// How much lamplight reaches a place, 0 to 1.
fn lamplight(place: vec3<f32>, room: u32) -> f32 {
    let raw = (place.xy + SLANT * place.z - shadows.origin) * shadows.texels_a_metre - 0.5;
    let at = clamp(raw, vec2(2.0), shadows.most);
    // What lies beyond the map is free.
    if any(raw != at) {
        return 1.0;
    }
    let limit = (i32(clamp(place.z * 1000.0, 0.5, 4095.0)) << 4u) | 15;
    let whole = floor(at);
    let wx = tent(at.x - whole.x);
    let wy = tent(at.y - whole.y);
    let first = vec2<i32>(whole) - 1;
    var dark = 0.0;
    for (var y = 0; y < 4; y++) {
        var row = 0.0;
        for (var x = 0; x < 4; x++) {
            let texel = i32(textureLoad(shadow_map, first + vec2(x, y), 0).r);
            let over = texel - limit;
            if over > 0 && u32(texel & 15) == room {
                row += clamp(1.3 - f32(over) * FADE, 0.0, 1.0) * wx[x];
            }
        }
        dark += row * wy[y];
    }
    return 1.0 - dark;
}

// Frost, dirt and slime over any surface.
fn weathered(piece: u32, flags: u32, base: vec3<f32>, from_mesh: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let i = pieces[piece].inverse;
    let place = i[0].xyz * from_mesh.x + i[1].xyz * from_mesh.y + i[2].xyz * from_mesh.z;
    var albedo = base;
    if (flags & DIRTY) != 0u {
        albedo = mix(albedo, DIRT, clamp((spots(place, 14.0) - 0.985) * 14.0, 0.0, 0.85));
    }
    if (flags & INFECTED) != 0u {
        albedo = mix(albedo, SLIME, clamp((spots(place, 10.0) - 0.99) * 12.0, 0.0, 0.8));
    }
    if (flags & COLD) != 0u {
        let amount = 0.38 + 0.3 * max(normal.z, 0.0) + clamp((spots(place, 18.0) - 1.0) * 3.0, -0.2, 0.25);
        albedo = mix(albedo, FROST, amount);
    }
    return albedo;
}

fn spots(place: vec3<f32>, scale: f32) -> f32 {
    let at = place * scale;
    let on = vec2(at.x + at.z * 0.71, at.y + at.z * 0.53) * shadows.spots_a_metre;
    return factor(shadows.spots, on, 0.0).r;
}

fn paint_of(surface: u32, piece: u32) -> vec3<f32> {
    let paint = surfaces[surface].paint;
    if paint.w == 1.0 {
        return pieces[piece].tint.rgb;
    }
    if paint.w == 2.0 {
        return pieces[piece].fluid.rgb;
    }
    return paint.rgb;
}

// The direction through a pixel, one metre ahead.
fn ray_through(camera: u32, at: vec2<f32>) -> vec3<f32> {
    let slope = (at - cameras[camera].tile.xy - vec2(cameras[camera].right.w, cameras[camera].down.w))
        / cameras[camera].eye.w;
    return cameras[camera].forward.xyz + cameras[camera].right.xyz * slope.x + cameras[camera].down.xyz * slope.y;
}

fn color_of(in: Corner, ray: vec3<f32>, depth: f32, normal: vec3<f32>, slant: f32) -> vec3<f32> {
    let piece = in.what.x;
    let surface = in.what.z;
    let pattern = surfaces[surface].pattern;
    let flags = pieces[piece].flags;
    let kind = pattern.w;
    if kind == SKY {
        return outside(normalize(ray));
    }
    let paint = paint_of(surface, piece);
    if kind == GLOW {
        return paint * 1.15;
    }
    if kind == LAMP {
        return paint * select(0.12, 1.9, (flags & LIT) != 0u);
    }
    let i = pieces[piece].inverse;
    let room_light = vec3(i[0].w, i[1].w, i[2].w);
    var albedo = paint;
    if pattern.x >= 0.0 {
        let pixel_m2 = cameras[in.what.y].forward.w;
        let texels = max(pixel_m2 * depth * depth * slant * pattern.z, 1.0);
        // Half of the logarithm is the root's.
        let level = min(((bitcast<u32>(texels) >> 23u) - 127u) / 2u, LEVELS - 1u);
        albedo *= factor(pattern.x, in.laid.xy, f32(level));
    }
    let away = ray * depth;
    let eye = cameras[in.what.y].eye.xyz;
    if (flags & (DIRTY | COLD | INFECTED)) != 0u {
        let r = pieces[piece].rotation;
        albedo = weathered(piece, flags, albedo, away + (eye - vec3(r[0].w, r[1].w, r[2].w)), normal);
    }
    albedo *= room_light;
    let ambient = clamp(in.laid.z, 0.0, 1.4);
    let facing = max(dot(normal, TOWARDS_LIGHT), 0.0);
    var lit = 0.0;
    if facing > 0.0 {
        lit = lamplight(eye + away + normal * LIFT_M + vec3(0.0, 0.0, 0.008), pieces[piece].room);
    }
    let aside = 1.0 + 0.07 * normal.x - 0.05 * normal.y;
    let around = (BELOW + (ABOVE - BELOW) * (normal.z * 0.5 + 0.5)) * aside;
    var light = albedo * (around * (ambient * (0.8 + 0.2 * lit)) + KEY * (facing * lit * (0.4 + 0.6 * ambient)));
    let gloss = surfaces[surface].gloss;
    if gloss.x > 0.0 {
        let direction = normalize(ray);
        let along = dot(direction, normal);
        let thrown = direction - normal * (2.0 * along);
        var power = max(dot(thrown, TOWARDS_LIGHT), 0.0);
        for (var turn = 0.0; turn < gloss.y; turn += 1.0) {
            power *= power;
        }
        let grazing = clamp(1.0 + along, 0.0, 1.0);
        let room = 0.22 + 0.75 * clamp(thrown.z * 0.7 + 0.45, 0.0, 1.0);
        let mirror = (gloss.z + 0.25 * gloss.x * grazing * grazing * grazing) * room * ambient;
        let amount = gloss.x * power * (0.35 + 0.65 * lit) + mirror;
        light += select(room_light, albedo * 1.1, gloss.w > 0.0) * max(amount, 0.0);
    }
    return light;
}

fn packed(normal: vec3<f32>) -> u32 {
    let bytes = vec3<u32>(vec3<i32>(round(normal * 127.0))) & vec3(255u);
    return bytes.x | (bytes.y << 8u) | (bytes.z << 16u);
}

@fragment
fn solid(in: Corner) -> Pixel {
    // What a pixel's share of the surface is drawn out by: one over the cosine between the ray and the triangle.
    let across = cross(dpdx(in.away), dpdy(in.away));
    let depth = 1.0 / in.at.w;
    let ray = ray_through(in.what.y, in.at.xy);
    let slant = length(ray) * length(across) / max(abs(dot(ray, across)), 1e-20);
    let normal = in.normal * inverseSqrt(max(dot(in.normal, in.normal), 1e-12));
    var out: Pixel;
    if COLORED {
        out.color = vec4(display(color_of(in, ray, depth, normal, min(slant, 12.5))), 1.0);
    }
    out.depth_m = depth;
    out.normal = packed(normal);
    out.id = pieces[in.what.x].id;
    out.facet = in.facet;
    return out;
}

// As corner, but for normals, which are of unit length at the corners.
@vertex
fn veil_corner(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) ambient: f32,
    @location(3) surface: u32,
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> Corner {
    var out = placed(position, normal, ambient, surface, vertex, instance);
    out.normal *= inverseSqrt(max(dot(out.normal, out.normal), 1e-24));
    return out;
}

// Linear light, and how much of what is behind it hides.
fn veil_color(in: Corner, ray: vec3<f32>, normal: vec3<f32>) -> vec4<f32> {
    let piece = in.what.x;
    let surface = in.what.z;
    let look = surfaces[surface].veil;
    let flags = pieces[piece].flags;
    var paint = paint_of(surface, piece);
    var squarely = look.x;
    if !AIRY {
        if (flags & DIRTY) != 0u {
            paint = mix(paint, VEIL_DIRT, 0.6);
            squarely += (1.0 - squarely) * 0.35;
        }
        if (flags & INFECTED) != 0u {
            paint = mix(paint, SLIME, 0.6);
            squarely += (1.0 - squarely) * 0.3;
        }
        if (flags & COLD) != 0u {
            paint = mix(paint, VEIL_FROST, 0.6);
            squarely += (1.0 - squarely) * 0.45;
        }
    }
    let direction = normalize(ray);
    let along = dot(direction, normal);
    let cosine = clamp(-along, 0.0, 1.0);
    let thrown = direction - normal * (2.0 * along);
    var power = clamp(dot(thrown, TOWARDS_LIGHT), 0.0, 1.0);
    for (var turn = 0; turn < 6; turn++) {
        power *= power;
    }
    let highlight = power * look.z;
    let aside = 1.0 - cosine;
    let share = select(1.0 - aside * aside * aside, cosine * cosine, AIRY);
    let opacity = clamp(look.y + (squarely - look.y) * share + highlight, 0.0, 1.0);
    if look.w > 0.0 {
        let core = cosine * cosine * cosine;
        return vec4(mix(paint * 1.15, vec3(1.9), core * core), opacity);
    }
    let i = pieces[piece].inverse;
    let mirror = aside * aside * aside * 0.5 * (0.22 + 0.75 * clamp(thrown.z * 0.7 + 0.45, 0.0, 1.0));
    let around = 0.3 + BELOW + (ABOVE - BELOW) * (normal.z * 0.5 + 0.5);
    return vec4(vec3(i[0].w, i[1].w, i[2].w) * (paint * around + look.z * mirror + highlight), opacity);
}

@fragment
fn veil(in: Corner) -> Pixel {
    let normal = in.normal * inverseSqrt(max(dot(in.normal, in.normal), 1e-12));
    var out: Pixel;
    if COLORED {
        let color = veil_color(in, ray_through(in.what.y, in.at.xy), normal);
        out.color = vec4(display(color.rgb), color.a);
    }
    out.depth_m = 1.0 / in.at.w;
    out.normal = packed(normal);
    out.id = pieces[in.what.x].id;
    out.facet = in.facet;
    return out;
}

struct Backdrop {
    @builtin(position) at: vec4<f32>,
    @location(0) @interpolate(flat) camera: u32,
}

// A triangle over the whole picture, just this side of where everything ends.
@vertex
fn backdrop(@builtin(vertex_index) vertex: u32, @builtin(instance_index) camera: u32) -> Backdrop {
    var out: Backdrop;
    let x = f32(vertex & 1u) * 4.0 - 1.0;
    let y = f32(vertex >> 1u) * 4.0 - 1.0;
    out.at = vec4(x, y, NEAR_M / FAR_M * 1.00001, 1.0);
    out.camera = camera;
    return out;
}

@fragment
fn sky(in: Backdrop) -> @location(0) vec4<f32> {
    return vec4(display(outside(normalize(ray_through(in.camera, in.at.xy)))), 1.0);
}
