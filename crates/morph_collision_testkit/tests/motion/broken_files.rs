//! Readers refuse broken files with an error that says what is wrong and where.

use morph_collision_testkit::motion::records::{FramePair, find_records, parse_queries, read_queries};

/// Two queries: a vertex and a face, and two edges.
fn queries() -> Vec<u8> {
    let mut bytes = b"CCDQ".to_vec();
    bytes.extend([1_u32, 2, 200].map(u32::to_le_bytes).as_flattened());
    for kind in 0..2_u8 {
        for coordinate in 0..24 {
            bytes.extend(f64::from(coordinate).to_le_bytes());
        }
        bytes.extend([kind, 1, 3, 0]);
        bytes.extend(7_u32.to_le_bytes());
    }
    bytes
}

/// Four vertices, two faces, three edges and a pair of each kind.
fn frames() -> Vec<u8> {
    let mut bytes = b"CCDP".to_vec();
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    bytes.extend(words(&[1, 4, 3, 2, 1, 1, 8]));
    for coordinate in 0..24 {
        bytes.extend(f64::from(coordinate).to_le_bytes());
    }
    bytes.extend(words(&[0, 1, 2, 1, 2, 3]));
    bytes.extend(words(&[0, 1, 1, 2, 2, 3]));
    bytes.extend(words(&[3, 0]));
    bytes.extend([1, 0, 255, 0]);
    bytes.extend(words(&[0, 2]));
    bytes.extend([0, 1, 0, 0]);
    bytes
}

fn with(mut bytes: Vec<u8>, at: usize, value: &[u8]) -> Vec<u8> {
    bytes[at..at + value.len()].copy_from_slice(value);
    bytes
}

fn queries_error(bytes: &[u8]) -> String {
    parse_queries(bytes).expect_err("it is broken").to_string()
}

fn frames_error(bytes: &[u8]) -> String {
    FramePair::parse(bytes).expect_err("it is broken").to_string()
}

#[test]
fn whole_files_are_read() {
    let read = parse_queries(&queries()).unwrap();
    assert_eq!(read.len(), 2);
    assert_eq!(read[0].motion.points[1], [[3.0, 4.0, 5.0], [15.0, 16.0, 17.0]]);
    assert_eq!((read[1].touches, read[1].part, read[1].row), (true, 3, 7));
    let read = FramePair::parse(&frames()).unwrap();
    assert_eq!(read.vertices[1], [[3.0, 4.0, 5.0], [15.0, 16.0, 17.0]]);
    assert_eq!(
        (read.vertex_face[0].features, read.edge_edge[0].features),
        ([3, 0], [0, 2])
    );
    assert_eq!(
        (read.vertex_face[0].touches_rounded, read.edge_edge[0].touches_rounded),
        (None, Some(false))
    );
}

#[test]
fn files_cut_anywhere_or_too_long_are_refused() {
    for length in 0..queries().len() {
        assert!(parse_queries(&queries()[..length]).is_err(), "{length}");
    }
    for length in 0..frames().len() {
        assert!(FramePair::parse(&frames()[..length]).is_err(), "{length}");
    }
    let longer = [queries(), vec![0]].concat();
    assert_eq!(queries_error(&longer), "it has 417 bytes, but its header announces 416");
    let longer = [frames(), vec![0]].concat();
    assert_eq!(frames_error(&longer), "it has 297 bytes, but its header announces 296");
}

#[test]
fn counts_of_billions_are_refused_before_anything_is_allocated() {
    let many = u32::MAX.to_le_bytes();
    assert!(queries_error(&with(queries(), 8, &many)).contains("header announces 858993459016"));
    for at in (8..28).step_by(4) {
        assert!(frames_error(&with(frames(), at, &many)).contains("header announces"));
    }
}

#[test]
fn a_file_that_is_too_large_is_refused() -> std::io::Result<()> {
    let file = tempfile::NamedTempFile::new()?;
    file.as_file().set_len((1 << 28) + 1)?;
    let error = read_queries(file.path()).expect_err("it is too large").to_string();
    assert!(error.contains("over the limit of 268435456"), "{error}");
    Ok(())
}

#[test]
fn errors_name_what_is_wrong_and_where() {
    let nan = f64::NAN.to_le_bytes();
    let cases = [
        (
            with(queries(), 0, b"CCDP"),
            "the header's format is \"CCDP\", but should be \"CCDQ\"",
        ),
        (with(queries(), 4, &[2]), "the header's version is 2, but should be 1"),
        (
            with(queries(), 12, &[8]),
            "the header's record size is 8, but should be 200",
        ),
        (with(queries(), 16 + 200 + 8, &nan), "query 1: a coordinate is NaN"),
        (
            with(queries(), 16 + 192, &[2]),
            "query 0: the kind is 2, which has no meaning",
        ),
        (
            with(queries(), 16 + 193, &[7]),
            "query 0: the answer is 7, which has no meaning",
        ),
        (
            with(queries(), 16 + 195, &[1]),
            "query 0: the padding is 1, which has no meaning",
        ),
    ];
    for (bytes, message) in cases {
        assert_eq!(queries_error(&bytes), message);
    }
    let (faces, pairs) = (32 + 192, 32 + 192 + 24 + 24);
    let cases = [
        (
            with(frames(), 28, &[4]),
            "the header's size of a coordinate is 4, but should be 8",
        ),
        (with(frames(), 32 + 96, &nan), "vertex 0: a coordinate is NaN"),
        (
            with(frames(), faces + 12, &[4]),
            "face 1 refers to vertex 4, but there are 4",
        ),
        (
            with(frames(), faces + 24, &[9]),
            "edge 0 refers to vertex 9, but there are 4",
        ),
        (
            with(frames(), pairs, &[4]),
            "vertex-face pair 0 refers to vertex 4, but there are 4",
        ),
        (
            with(frames(), pairs + 4, &[2]),
            "vertex-face pair 0 refers to face 2, but there are 2",
        ),
        (
            with(frames(), pairs + 16, &[3]),
            "edge-edge pair 0 refers to edge 3, but there are 3",
        ),
        (
            with(frames(), pairs + 8, &[9]),
            "vertex-face pair 0: the answer is 9, which has no meaning",
        ),
        (
            with(frames(), pairs + 21, &[9]),
            "edge-edge pair 0: the source is 9, which has no meaning",
        ),
        (
            with(frames(), pairs + 22, &[9]),
            "edge-edge pair 0: the answer for rounded motion is 9, which has no meaning",
        ),
    ];
    for (bytes, message) in cases {
        assert_eq!(frames_error(&bytes), message);
    }
}

#[test]
fn any_changed_byte_gives_an_error_or_an_answer() {
    for at in 0..queries().len() {
        for value in [0, 1, 127, 128, 255] {
            let _ = parse_queries(&with(queries(), at, &[value]));
        }
    }
    for at in 0..frames().len() {
        for value in [0, 1, 127, 128, 255] {
            let _ = FramePair::parse(&with(frames(), at, &[value]));
        }
    }
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = read_queries("no such folder/x.ccdq".as_ref())
        .expect_err("there is none")
        .to_string();
    assert!(error.starts_with("no such folder/x.ccdq: it cannot be read"), "{error}");
    if let Err(missing) = find_records("ccdq") {
        assert!(missing.to_string().contains("ccd"));
    }
}
