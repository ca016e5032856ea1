tangible new photo.jpg                       # writes photo.yaml, with values that suit the picture
tangible legible photo.yaml --for swell      # can fingers read it on paper?
tangible export photo.yaml --to swell        # a page and its key, as SVG and PDF
# look at: out/photo/photo-swell.svg
