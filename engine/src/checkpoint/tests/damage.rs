//! Whatever is damaged, cut off or forged is refused.

use super::*;

/// Every bit of the file: header, clock, scene, columns and the padding between them.
#[test]
fn every_flipped_bit_is_noticed() {
    let (_folder, path, _) = written(500);
    let mut bytes = aligned(&path);
    check(&bytes).unwrap();
    let bits = 8 * bytes.len();
    assert!(bits - 8 * HEADER_LENGTH > 100_000, "{bits} are too few");
    for bit in 0..bits {
        bytes[bit / 8] ^= 1 << (bit % 8);
        match check(&bytes) {
            Ok(()) => panic!("bit {bit} went unnoticed"),
            Err(error) => assert!(error.is_damage(), "bit {bit}: {error}"),
        }
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
    check(&bytes).unwrap();
}

/// The header with other bytes at a place, and a checksum that fits.
fn forged(path: &Path, place: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = fs::read(path).unwrap();
    file[place..][..bytes.len()].copy_from_slice(bytes);
    let checksum = xxh3_64(&file[..HEADER_LENGTH - 8]);
    file[HEADER_LENGTH - 8..HEADER_LENGTH].copy_from_slice(&checksum.to_le_bytes());
    file
}

#[test]
fn another_version_or_byte_order_is_no_damage() {
    let (_folder, path, _) = written(5);
    let newer = forged(&path, 8, &2_u32.to_le_bytes());
    let mut swapped = fs::read(&path).unwrap();
    swapped[HEADER_LENGTH - 8..HEADER_LENGTH].reverse();
    for (bytes, sentence) in
        [(newer, "found format version 2, expected 1"), (swapped, "most significant byte first")]
    {
        fs::write(&path, bytes).unwrap();
        let error = read(&path).unwrap_err();
        assert!(error.to_string().contains(sentence), "{error}");
        assert!(!error.is_damage());
        // What may be whole is not passed over: a run that goes on without it would replace it.
        let folder = path.parent().unwrap();
        let older = folder.join(file_name(1));
        write(&older, &sample(5)).unwrap();
        assert!(newest_valid(folder).unwrap_err().to_string().contains(sentence));
    }
}

/// Whatever the header's words claim under a right checksum, nothing is read beyond the file.
#[test]
fn forged_lengths_are_refused() {
    let (_folder, path, _) = written(20);
    let whole = fs::read(&path).unwrap();
    let mut state = 1_u64;
    for _ in 0..2000 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let place = [16, 24, 40][(state >> 40) as usize % 3];
        let word = state >> (state >> 58);
        let mut memory = rkyv::util::AlignedVec::<16>::new();
        memory.extend_from_slice(&forged(&path, place, &word.to_le_bytes()));
        let checked = check(&memory);
        // A length that ends within the same page is nonsense, too, but does no harm.
        let pages = |word: u64| word.checked_next_multiple_of(HEADER_LENGTH as u64);
        let true_word = u64::from_le_bytes(whole[place..place + 8].try_into().unwrap());
        assert!(checked.is_err() || pages(word) == pages(true_word), "{place}: {word}");
    }
}

#[test]
fn damage_in_a_file_is_noticed_by_both_readers() {
    let (_folder, path, _) = written(500);
    let whole = fs::read(&path).unwrap();
    let verify = |path: &Path| Mapped::open(path).and_then(|mapped| mapped.verify());
    for place in [0, 9, 70, 4095, 4100, 8191, 8192, 9000, whole.len() - 1] {
        let mut bytes = whole.clone();
        bytes[place] ^= 16;
        fs::write(&path, &bytes).unwrap();
        assert!(read(&path).unwrap_err().is_damage());
        assert!(verify(&path).unwrap_err().is_damage());
    }
    for length in [0, 1, 4095, 4096, 4097, 8192, whole.len() - 1] {
        fs::write(&path, &whole[..length]).unwrap();
        assert!(read(&path).unwrap_err().is_damage());
        assert!(verify(&path).unwrap_err().is_damage());
    }
    fs::write(&path, [&whole[..], &[0]].concat()).unwrap();
    assert!(matches!(read(&path), Err(CheckpointError::Length { .. })));
}

#[test]
fn every_truncation_is_noticed() {
    let (_folder, path, _) = written(500);
    let bytes = aligned(&path);
    for length in 0..bytes.len() {
        assert!(check(&bytes[..length]).is_err(), "{length} bytes passed");
    }
}

#[test]
fn a_forged_header_is_refused_without_allocating() {
    let (_folder, path, _) = written(5);
    let original = fs::read(&path).unwrap();
    for length in [1 << 40, 1 << 62, u64::MAX - 5000, u64::MAX] {
        let section = Section { length, checksum: 0 };
        for (preface, columns) in [(section, Section::default()), (section, section)] {
            let header = Header { preface, columns, ..Header::default() };
            let forged = [&header.encode(), &original[HEADER_LENGTH..]].concat();
            fs::write(&path, forged).unwrap();
            assert!(matches!(read(&path), Err(CheckpointError::Length { .. })));
        }
    }
}

#[test]
fn a_header_that_contradicts_the_clock_is_refused() {
    let (_folder, path, _) = written(5);
    let bytes = fs::read(&path).unwrap();
    let mut header = Header::decode(&path, &bytes, bytes.len() as u64).unwrap();
    header.step += 1;
    fs::write(&path, [&header.encode(), &bytes[HEADER_LENGTH..]].concat()).unwrap();
    let error = read(&path).unwrap_err().to_string();
    assert!(error.contains("disagree about the step"), "{error}");
}
