tangible export photo.jpg --to pins --set export.pins.display=monarch
# look at: out/photo/photo-monarch.png
