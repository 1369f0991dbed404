//! The example `netcode`: two peers with latency and prediction.

#[path = "../../examples/netcode.rs"]
#[allow(dead_code, reason = "`main` is not called here")]
mod program;

#[test]
fn two_peers_that_roll_back_end_with_the_same_checksum() {
    let report = program::play_together(600);
    assert!(report.is_in_sync, "{report}");
    assert!(report.rollbacks.iter().all(|&rollbacks| rollbacks > 30), "{report}");
    let again = report.simulated.map(|simulated| simulated - report.frames);
    assert!(again.iter().all(|&again| again > 200), "{report}");
    assert!(report.hits[0] > 20 && report.hits[0] == report.hits[1], "{report}");
}
