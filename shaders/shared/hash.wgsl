// Counter-based random numbers, bit for bit those of src/math/hash.rs. 64-bit numbers are (low, high).
#define_import_path furrier::hash

fn wide_add(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2(low, a.y + b.y + u32(low < a.x));
}

// The lower 64 bits of a product.
fn wide_multiply(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let al = a.x & 0xffffu;
    let ah = a.x >> 16u;
    let bl = b.x & 0xffffu;
    let bh = b.x >> 16u;
    let middle = ah * bl + ((al * bl) >> 16u);
    let rest = al * bh + (middle & 0xffffu);
    let high = ah * bh + (middle >> 16u) + (rest >> 16u);
    return vec2(a.x * b.x, high + a.x * b.y + a.y * b.x);
}

// x ^ (x >> by), 0 < by < 32.
fn wide_fold(x: vec2<u32>, by: u32) -> vec2<u32> {
    return x ^ vec2((x.x >> by) | (x.y << (32u - by)), x.y >> by);
}

// The finaliser of SplitMix64 (Steele et al. 2014).
fn mix_key(key: vec2<u32>) -> vec2<u32> {
    var k = wide_add(key, vec2(0x7F4A7C15u, 0x9E3779B9u));
    k = wide_multiply(wide_fold(k, 30u), vec2(0x1CE4E5B9u, 0xBF58476Du));
    k = wide_multiply(wide_fold(k, 27u), vec2(0x133111EBu, 0x94D049BBu));
    return wide_fold(k, 31u);
}

fn combine(seed: vec2<u32>, value: vec2<u32>) -> vec2<u32> {
    return mix_key(seed ^ mix_key(value));
}

// A whole number as its two's complement in 64 bits.
fn wide_of(value: i32) -> vec2<u32> {
    return vec2(bitcast<u32>(value), select(0u, 0xffffffffu, value < 0));
}

// Uniform in [0, 1) from the upper 24 bits.
fn unit(hash: vec2<u32>) -> f32 {
    return f32(hash.y >> 8u) * (1.0 / 16777216.0);
}
