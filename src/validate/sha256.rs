//! SHA-256 of the pixels of stored pictures.

use crate::picture::Picture;
use sha2::{Digest, Sha256};

/// The digest of the decoded pixels as f32 in little endian, R, G, B, row by row from the top; 64 hexadecimal digits.
pub fn of_pixels(picture: &Picture) -> String {
    let bytes: Vec<u8> = picture.pixels.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    digest(&bytes)
}

/// The digest of a message, 64 hexadecimal digits.
pub fn digest(message: &[u8]) -> String {
    Sha256::digest(message).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_examples() {
        // FIPS 180-4's examples by NIST, and the empty message.
        for (message, expected) in [
            ("", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"),
            ("abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"),
            (
                "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
                "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1",
            ),
        ] {
            assert_eq!(digest(message.as_bytes()), expected);
        }
        let million = vec![b'a'; 1_000_000];
        assert_eq!(digest(&million), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    }
}
