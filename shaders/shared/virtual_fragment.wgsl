// Virtual fragments of rays through undercoat, the virtual fragments of Andersen et al. 2016 §3.3, as linked lists by pixel.
#define_import_path furrier::virtual_fragment

// In place of the index of one.
const NO_VIRTUAL_FRAGMENT: u32 = 0xffffffffu;

struct VirtualFragment {
    radiance: vec3<f32>,
    // Depths along the optical axis, m.
    from_m: f32,
    to_m: f32,
    // Optical depth.
    depth: f32,
    // Six half floats: mean colour, mean hair direction.
    faces: vec3<u32>,
    // The one behind it, or nothing.
    next: u32,
}

fn pack_faces(albedo: vec3<f32>, tangent: vec3<f32>) -> vec3<u32> {
    return vec3(pack2x16float(albedo.xy), pack2x16float(vec2(albedo.z, tangent.x)), pack2x16float(tangent.yz));
}

fn unpack_albedo(faces: vec3<u32>) -> vec3<f32> {
    return vec3(unpack2x16float(faces.x), unpack2x16float(faces.y).x);
}

fn unpack_tangent(faces: vec3<u32>) -> vec3<f32> {
    return vec3(unpack2x16float(faces.y).y, unpack2x16float(faces.z));
}
