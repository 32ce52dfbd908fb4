// A hair's look, as src/shade/law/known.rs packs it: how its fibre scatters, what colours it wears, the law of fur of it.
#define_import_path furrier::look

// Factors of D's terms; then what D is divided by beside cos θ, the tilt, and the sharpness along the hair.
struct FibreLobe {
    even: vec4<f32>,
    odd: vec4<f32>,
    last: vec4<f32>,
}

struct Look {
    lobes: array<FibreLobe, 4>,
    // Path of each lobe through the fibre, radii.
    paths: vec4<f32>,
    // Reflectance of the surface, its norm, concentration of what goes straight through, its norm.
    surface: vec4<f32>,
    // Of what is reflected inside: along cos(φ/2), all around, each glint, the glints' concentration.
    inner: vec4<f32>,
    // Cosine and sine of where the glints stand; of what the medulla scatters: factors of 1 and cos φ.
    glint: vec4<f32>,
    // Of what the medulla scatters: factor of cos² φ; 1 over the square of the index; the darkest and lightest colour.
    rest: vec4<f32>,
    // Factors of powers: of ln((C - darkest)/(lightest - C)) in ln σ.
    colouring: vec4<f32>,
    // The factor of the fourth power.
    colouring_last: vec4<f32>,
    // Factors of the law's terms, each a cubic in the colour's logit.
    light: array<vec4<f32>, 22>,
    sky: array<vec4<f32>, 12>,
}
