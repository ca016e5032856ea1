tangible export photo.jpg --to page       # one file, which anybody can open and explore
# look at: out/photo/photo-page.html
