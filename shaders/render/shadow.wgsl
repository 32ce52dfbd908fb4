// Fills the stored shadow, the optical depth of undercoat towards the key light: one thread per column of sub-elements
// and layer.
#import furrier::scene::{scene, triangles, lights}
#import furrier::prism::{Place, jacobian, subelement_centre}
#import furrier::undercoat::code_value
#import furrier::march::{advance, walk_from, Stepping, MOST_STEPS}
#import furrier::blocks::{blocks, write_byte, owner_of}

// Optical depth beyond which no light is left.
const DARK: f32 = 6.0;

@compute @workgroup_size(64)
fn shadow(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + local;
    let layer = index % scene.layers;
    let column = index / scene.layers;
    if column >= blocks.columns {
        return;
    }
    let triangle = owner_of(column);
    let first = triangles[triangle].shadow_at;
    let d = triangles[triangle].shadow_splits;
    let element = column - first;
    let b = subelement_centre(element, d);
    var walk = walk_from(0.0, triangle, Place(b.yz, (f32(layer) + 0.5) / f32(scene.layers)));
    let origin_m = jacobian(walk.prism, walk.place).at_m;
    var depth = 0.0;
    for (var i = 0u; i < MOST_STEPS && walk.alive && depth < DARK; i++) {
        // Steps towards the light may be long: what they miss is blurred by the shadow's own resolution.
        depth += advance(&walk, origin_m, lights[0].to_light, 1e30, Stepping(1.0, 4.0)).depth;
    }
    write_byte(first * scene.layers + (layer << (2u * d)) + element, code_value(depth));
}
