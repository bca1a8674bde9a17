//! The numbers within the page: typed arrays in one block, base64.

use serde_json::{Value, json};

use crate::output::base64;

/// Arrays, each at an offset that is a multiple of its type's size.
#[derive(Default)]
pub(super) struct Block {
    bytes: Vec<u8>,
    arrays: serde_json::Map<String, Value>,
}

impl Block {
    pub fn floats(&mut self, name: &str, values: impl IntoIterator<Item = f32>) {
        let bytes = values.into_iter().flat_map(f32::to_le_bytes).collect();
        self.array(name, "Float32Array", 4, bytes);
    }

    pub fn words(&mut self, name: &str, values: impl IntoIterator<Item = u32>) {
        let bytes = values.into_iter().flat_map(u32::to_le_bytes).collect();
        self.array(name, "Uint32Array", 4, bytes);
    }

    pub fn halves(&mut self, name: &str, values: impl IntoIterator<Item = u16>) {
        let bytes = values.into_iter().flat_map(u16::to_le_bytes).collect();
        self.array(name, "Uint16Array", 2, bytes);
    }

    pub fn signed_halves(&mut self, name: &str, values: impl IntoIterator<Item = i16>) {
        let bytes = values.into_iter().flat_map(i16::to_le_bytes).collect();
        self.array(name, "Int16Array", 2, bytes);
    }

    pub fn bytes(&mut self, name: &str, values: impl IntoIterator<Item = u8>) {
        self.array(name, "Uint8Array", 1, values.into_iter().collect());
    }

    fn array(&mut self, name: &str, kind: &str, size: usize, content: Vec<u8>) {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let entry = json!([kind, self.bytes.len(), content.len() / size]);
        self.arrays.insert(name.to_owned(), entry);
        self.bytes.extend(content);
    }

    /// Type, offset and length of each array, and the bytes.
    pub fn finish(self) -> (Value, String) {
        (Value::Object(self.arrays), base64(&self.bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_start_where_the_index_says() {
        let mut block = Block::default();
        block.halves("a", [1, 2, 0x0403]);
        block.floats("b", [1.0]);
        block.signed_halves("c", [-1]);
        let (index, text) = block.finish();
        assert_eq!(
            index,
            json!({"a": ["Uint16Array", 0, 3], "b": ["Float32Array", 8, 1], "c": ["Int16Array", 12, 1]})
        );
        // 01 00 02 00 03 04 | 00 00 | 00 00 80 3f | ff ff
        assert_eq!(text, "AQACAAMEAAAAAIA///8=");
    }
}
