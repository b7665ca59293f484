# Builds the command from the source archive of a release.
#
# The checksum exists only once that archive does: `scripts/packaging_checksums.py` writes a copy of this file in which the marked
# line is the archive's checksum. That copy, which every release has among its files, goes into a tap.
class Slcal < Formula
  desc "Projector-camera calibration and structured-light reconstruction"
  homepage "https://github.com/slcal/slcal"
  url "https://github.com/slcal/slcal/releases/download/v0.1.0/slcal-0.1.0.tar.gz"
  # sha256: filled by scripts/packaging_checksums.py
  license any_of: ["MIT", "Apache-2.0"]
  head "https://github.com/slcal/slcal.git", branch: "main"

  depends_on "rust" => :build

  def install
    system "cargo", "install", *std_cargo_args(path: "crates/slcal-cli")
    generate_completions_from_executable(bin/"slcal", "completions")
    mkdir "man"
    system bin/"slcal", "man", "--out", "man"
    man1.install Dir["man/*.1"]
  end

  test do
    assert_match version.to_s, shell_output("#{bin}/slcal --version")
    # The whole chain on photographs that are built in.
    system bin/"slcal", "demo", "--out", testpath/"demo"
    assert_path_exists testpath/"demo/rig.json"
  end
end
