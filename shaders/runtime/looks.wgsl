// The look of the hair that is drawn, and what each layer of its tile holds.
#define_import_path furrier::looks

#import furrier::look::Look

struct LayerLook {
    // Hair area per volume times diameter.
    crowding: f32,
    // Hair area of the layer per skin area, in the mean.
    area: f32,
    // Hair area above the layer's top over that above its middle.
    top_share: f32,
    // Height over which the hair area above falls to 1/e, over the stack's.
    scale: f32,
}

@group(1) @binding(7) var<storage, read> looks: array<Look>;
@group(1) @binding(8) var<storage, read> layer_looks: array<LayerLook>;
