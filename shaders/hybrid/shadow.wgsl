// Fills the stored shadow, the optical depth of undercoat, and of guard hair in the mean, towards the key light: one thread
// per corner of sub-elements and level.
#import furrier::constants::{AT_BORDER, DARK, DARK_AT_BORDERS, STEP_GROWTH, MOST_STEPS, MOST_STEP_GROWTH, MOST_STEP_LENGTHENING,
    SHADOW_STEP_DEPTH, SHADOW_STEP_LAYERS}
#import furrier::scene::{scene, triangles, lights}
#import furrier::prism::{ShellPoint, jacobian, corners_of, corner_point}
#import furrier::undercoat::code_value
#import furrier::march::{advance, walk_from, Stepping}
#import furrier::light::light_at
#import furrier::blocks::{blocks, write_byte, owner_of}
#import furrier::mean_shadow::{mean_depths, tips_m}

@compute @workgroup_size(64)
fn shadow(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + local;
    let level = index % (scene.layers + 1u);
    let column = index / (scene.layers + 1u);
    if column >= blocks.columns {
        return;
    }
    let triangle = owner_of(column);
    let first = triangles[triangle].shadow_at;
    let d = triangles[triangle].shadow_splits;
    let corner = column - first;
    let b = corner_point(corner, d);
    let t = f32(level) / f32(scene.layers);
    var walk = walk_from(0.0, triangle, ShellPoint(b.yz, t));
    let origin_m = jacobian(walk.prism, walk.point).at_m;
    let to_light = light_at(lights[0], origin_m).to_light;
    let enough = select(DARK, DARK_AT_BORDERS, (triangles[triangle].traits & AT_BORDER) != 0u);
    var depth = 0.0;
    for (var i = 0u; i < MOST_STEPS && walk.alive && depth < enough; i++) {
        // Steps towards the light may be long: what they miss is blurred by the shadow's own resolution.
        let scale = min(1.0 + STEP_GROWTH * depth, MOST_STEP_GROWTH);
        let stepping = Stepping(SHADOW_STEP_DEPTH * scale, SHADOW_STEP_LAYERS * min(scale, MOST_STEP_LENGTHENING));
        depth += advance(&walk, origin_m, to_light, 1e30, stepping).depth;
    }
    depth += mean_depths(triangle, b, t * scene.undercoat_top_m / tips_m()).y;
    write_byte(first * (scene.layers + 1u) + level * corners_of(d) + corner, code_value(depth));
}
