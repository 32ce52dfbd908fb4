// Fills the stored density: one thread per column of sub-elements.
#import furrier::scene::{scene, triangles}
#import furrier::prism::subelement_centre
#import furrier::undercoat::{column_over, column_crowding, code_value}
#import furrier::blocks::{blocks, write_byte, owner_of}

@compute @workgroup_size(64)
fn density(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + local;
    if index >= blocks.columns {
        return;
    }
    let triangle = owner_of(index);
    let first = triangles[triangle].density_at;
    let d = triangles[triangle].density_splits;
    let element = index - first;
    let column = column_over(triangle, subelement_centre(element, d));
    for (var layer = 0u; layer < scene.layers; layer++) {
        let value = column_crowding(column, (f32(layer) + 0.5) / f32(scene.layers));
        write_byte(first * scene.layers + (layer << (2u * d)) + element, code_value(value));
    }
}
