// The looks of guard hair and undercoat.
#define_import_path furrier::looks

#import furrier::look::Look

@group(0) @binding(8) var<storage, read> looks: array<Look>;
