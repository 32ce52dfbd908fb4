// Blocks of sub-elements while they are filled.
#define_import_path furrier::blocks

struct Blocks {
    // Columns in all blocks, and blocks.
    columns: u32,
    count: u32,
}

@group(2) @binding(0) var<uniform> blocks: Blocks;
// First column and triangle of each block, in order.
@group(2) @binding(1) var<storage, read> block_starts: array<vec2<u32>>;
@group(2) @binding(2) var<storage, read_write> filled: array<atomic<u32>>;

// The triangle that column `index` belongs to.
fn owner_of(index: u32) -> u32 {
    var low = 0u;
    var high = blocks.count;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if block_starts[middle].x <= index {
            low = middle;
        } else {
            high = middle;
        }
    }
    return block_starts[low].y;
}

// Every byte is written once, over zero.
fn write_byte(byte: u32, value: u32) {
    atomicOr(&filled[byte >> 2u], value << (8u * (byte & 3u)));
}
