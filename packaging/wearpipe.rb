class Wearpipe < Formula
  desc "Remaining wear life of hydraulic pumps from the debris they shed"
  homepage "https://example.org/wearpipe"
  url "file:///tmp/wearpipe-0.1.0.tar.gz" # made by: make dist
  version "0.1.0"
  license "GPL-3.0-or-later"

  depends_on "pkgconf" => :build
  depends_on "fftw"
  depends_on "gnuplot"
  depends_on "gsl"
  depends_on "libsndfile"

  def install
    system "make", "all", "build/install/wearpipe", "build/install/_wearpipe", "build/install/wearpipe.fish"
    bin.install Dir["bin/*"]
    man1.install Dir["man/*.1"]
    man5.install Dir["man/*.5"]
    man7.install Dir["man/*.7"]
    bash_completion.install "build/install/wearpipe"
    zsh_completion.install "build/install/_wearpipe"
    fish_completion.install "build/install/wearpipe.fish"
    pkgshare.install "share/arrivals.net"
    doc.install "README.md", "CHANGELOG.md", "LICENSE", "doc/tutorials", "examples"
  end

  test do
    system "sh", "-c", "#{bin}/roughgen --points 16 | #{bin}/bemcontact --pressure 1MPa --estar 1GPa >out.nrrd"
    assert_predicate testpath/"out.nrrd", :exist?
  end
end
