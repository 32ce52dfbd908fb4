//! Words in names that tell what has no fur, in the languages that models are named in.

/// Whole words, in small letters: parts of a body without fur, what is worn on eyes, and the ground.
const BARE: &[&str] = &[
    // English
    "eye eyes lefteye righteye leye reye eyeball eyeballs eyewhite eyewhites eyelens eyeline eyeliner iris irises cornea corneas pupil pupils \
     sclera scleras tear tears tearline tearduct tearducts lash lashes eyelash eyelashes brow brows eyebrow \
     eyebrows nose noses nostril nostrils whisker whiskers mouth innermouth mouthinside lip lips tooth teeth gum gums tongue fang fangs \
     tusk tusks beak beaks claw claws talon talons nail nails fingernail fingernails toenail toenails pad pads \
     pawpad pawpads hoof hoofs hooves horn horns antler antlers glasses eyeglasses sunglasses spectacles goggles \
     ground floor terrain",
    // German
    "auge augen augapfel hornhaut pupille pupillen wimper wimpern augenbraue augenbrauen nase schnurrhaare mund \
     maul lippe lippen zahn zähne zaehne zahnfleisch zunge schnabel kralle krallen nägel naegel huf hufe hörner \
     hoerner geweih brille boden",
    // French
    "oeil œil yeux cornée cornee pupilles cils sourcil sourcils nez moustaches bouche lèvres levres dent dents \
     gencive gencives langue bec griffe griffes ongle ongles sabot sabots corne cornes lunettes",
    // Spanish, Portuguese and Italian
    "ojo ojos pestañas pestanas ceja cejas nariz bigotes boca labios diente dientes encía encías encias lengua pico \
     garra garras uña uñas pezuña pezuñas cuerno cuernos gafas suelo olho olhos íris cílios cilios sobrancelha \
     sobrancelhas lábios dentes gengiva gengivas língua bico unha unhas casco cascos chifre chifres óculos chão \
     occhio occhi pupilla pupille ciglia sopracciglia naso baffi bocca labbra denti dente gengive lingua becco \
     artiglio artigli unghia unghie zoccolo zoccoli corno corna occhiali pavimento",
    // Russian
    "глаз глаза зрачок зрачки роговица ресницы бровь брови нос усы рот губы зуб зубы дёсны десны язык клюв коготь \
     когти ногти копыто копыта рог рога очки",
    // Japanese and Chinese; within other words it means much else
    "角",
    // Korean
    "눈 눈알 눈동자 속눈썹 눈썹 코 수염 입 입술 이빨 치아 잇몸 혀 부리 발톱 손톱 발굽 뿔 안경 바닥",
];

/// Parts of words, for names in Japanese and Chinese, which set no spaces.
const WITHIN: &str = "目 眼 瞳 睛 虹彩 角膜 ハイライト アイライン 睫 まつげ まつ毛 マツゲ 眉 まゆ マユ \
     鼻 ひげ ヒゲ 髭 胡须 胡須 口 くち 唇 歯 齿 齒 牙 キバ 歯茎 舌 嘴 くちばし クチバシ 爪 ツメ \
     指甲 肉球 蹄 ひづめ ツノ メガネ めがね 眼鏡 眼镜 地面 床";

/// The word in a name that tells that what it names has no fur. Words end at anything but letters, and where a capital begins one.
pub fn bare_word(name: &str) -> Option<String> {
    let letters: Vec<char> = name.chars().collect();
    let mut words = vec![String::new()];
    for (i, &c) in letters.iter().enumerate() {
        let before = i.checked_sub(1).map(|i| letters[i]);
        let after = letters.get(i + 1);
        // `leftEye`, and `LEye`.
        let begins = c.is_uppercase()
            && before
                .is_some_and(|b| b.is_lowercase() || (b.is_uppercase() && after.is_some_and(|a| a.is_lowercase())));
        if !c.is_alphabetic() || begins {
            words.push(String::new());
        }
        if c.is_alphabetic() {
            words.last_mut()?.extend(c.to_lowercase());
        }
    }
    let listed = |word: &String| BARE.iter().any(|list| list.split(' ').any(|bare| bare == word));
    let whole = words.into_iter().find(listed);
    whole.or_else(|| WITHIN.split(' ').find(|part| name.contains(*part)).map(str::to_owned))
}

/// Whether a name tells that what it names has no fur.
pub fn is_bare(name: &str) -> bool {
    bare_word(name).is_some()
}
