// The sound of an alarm: three tones. Browsers allow it once the person has touched the page; until then there is none.
const tones_Hz = [880, 660, 880];
const tone_s = 0.22;

let audio: AudioContext | null = null;

export function chime(): void {
  if (!navigator.userActivation?.hasBeenActive) return;
  try {
    audio ??= new AudioContext();
    const { currentTime: begin, destination } = audio;
    tones_Hz.forEach((frequency, i) => {
      const tone = audio!.createOscillator();
      const volume = audio!.createGain();
      const at = begin + i * tone_s;
      tone.frequency.value = frequency;
      // Neither begins nor ends with a click.
      volume.gain.setValueAtTime(0, at);
      volume.gain.linearRampToValueAtTime(0.25, at + 0.02);
      volume.gain.linearRampToValueAtTime(0, at + 0.9 * tone_s);
      tone.connect(volume).connect(destination);
      tone.start(at);
      tone.stop(at + tone_s);
    });
    if (audio.state === "suspended") void audio.resume();
  } catch (error) {
    console.info("no sound:", error);  // without a sound device; the banner stands all the same
  }
}
