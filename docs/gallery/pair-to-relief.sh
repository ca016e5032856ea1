tangible run left.png right.png --set want=relief --out out/pair
# look at: out/pair/sheet.png
