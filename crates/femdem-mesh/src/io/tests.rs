use super::*;

#[test]
fn endless_input_is_cut_off() {
    let endless = read_limited(std::io::repeat(b'v'), 1000);
    assert!(matches!(
        endless,
        Err(MeshError::FileTooLarge { allowed: 1000 })
    ));
    assert_eq!(read_limited(&[7; 1000][..], 1000).unwrap(), [7; 1000]);
}
