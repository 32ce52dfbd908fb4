// The looks of a tile's hair, and which of them each layer has.
#define_import_path furrier::looks

#import furrier::look::Look

struct LayerLook {
    // 0 guard hair, 1 undercoat.
    look: u32,
    // Hair area per volume times diameter.
    crowding: f32,
}

@group(1) @binding(7) var<storage, read> looks: array<Look>;
@group(1) @binding(8) var<storage, read> layer_looks: array<LayerLook>;
