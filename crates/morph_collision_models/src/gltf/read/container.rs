//! The chunks of a `.glb` file.

use std::ops::Range;

/// Size of the header of a `.glb` file in bytes.
const GLB_HEADER: usize = 12;

/// The ranges of a `.glb` that hold the JSON and, if there is one, the binary chunk.
pub(super) fn chunks(bytes: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>), String> {
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|word| <[u8; 4]>::try_from(word).ok());
        word.map(|word| u32::from_le_bytes(word) as usize)
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        let length = bytes.len();
        return Err(format!("the file ends after {length} bytes, inside the glb header"));
    };
    if version != 2 {
        return Err(format!("the glb header has version {version}"));
    }
    if length < GLB_HEADER || length > bytes.len() {
        let found = bytes.len();
        return Err(format!("the glb header promises {length} bytes, the file has {found}"));
    }
    let chunk = |at: usize, kind: &[u8; 4]| -> Result<Option<Range<usize>>, String> {
        let Some(size) = word(at) else { return Ok(None) };
        let start = at + 8;
        if bytes.get(at + 4..start) != Some(kind) {
            return Ok(None);
        }
        let end = start.checked_add(size).filter(|&end| end <= length);
        let end = end.ok_or_else(|| format!("the glb chunk at byte {at} reaches beyond the end"))?;
        Ok(Some(start..end))
    };
    let json = chunk(GLB_HEADER, b"JSON")?.ok_or("the glb file does not begin with a JSON chunk")?;
    let binary = chunk(json.end.next_multiple_of(4), b"BIN\0")?;
    Ok((json, binary))
}
